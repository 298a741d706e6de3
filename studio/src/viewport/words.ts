// Words over a picture that is made of pixels: what is said in a drawing, laid over a canvas.

/** Words, ready to be laid over a canvas. */
export class Words {
  private constructor(private readonly image: HTMLImageElement) {}

  /** Reads the text of an SVG file with nothing but words. */
  static async of(svg: string): Promise<Words> {
    const address = URL.createObjectURL(new Blob([svg], { type: "image/svg+xml" }));
    try {
      const image = new Image();
      image.src = address;
      await image.decode();
      return new Words(image);
    } finally {
      URL.revokeObjectURL(address);
    }
  }

  /** What a canvas shows at this moment, with the words over it, as a PNG. */
  over(shown: HTMLCanvasElement): Promise<Blob> {
    const { width, height } = shown;
    const picture = Object.assign(document.createElement("canvas"), { width, height });
    const pen = picture.getContext("2d")!;
    pen.drawImage(shown, 0, 0);
    pen.drawImage(this.image, 0, 0, width, height);
    return new Promise((resolve, reject) => {
      picture.toBlob((blob) =>
        blob ? resolve(blob) : reject(new Error("the picture can't be made")),
      );
    });
  }
}
