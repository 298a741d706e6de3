// Binary frames as the engine sends them (python/springform/studio/frames.py): a header, then arrays.
import type { MotionHeader, NetHeader, TableHeader } from "./messages";

type Header = NetHeader | MotionHeader | TableHeader;

/** The arrays of a frame by name. */
export interface Arrays {
  floats(name: string): Float32Array;
  integers(name: string): Int32Array;
  bytes(name: string): Uint8Array;
}

/** A frame, taken apart; its arrays are views of the buffer, not copies. */
export interface Frame {
  header: Header;
  arrays: Arrays;
}

/** Takes a frame apart. Throws `Error` if an array is missing or of another type. */
export function decodeFrame(buffer: ArrayBuffer, start = 0): Frame {
  const length = new DataView(buffer).getUint32(start, true);
  const text = new TextDecoder().decode(new Uint8Array(buffer, start + 4, length));
  const header = JSON.parse(text) as Header;
  const found = new Map<string, Float32Array | Int32Array | Uint8Array>();
  let offset = start + 4 + length;
  for (const { name, type, length: count } of header.arrays) {
    const array =
      type === "float32"
        ? new Float32Array(buffer, offset, count)
        : type === "int32"
          ? new Int32Array(buffer, offset, count)
          : new Uint8Array(buffer, offset, count);
    found.set(name, array);
    offset += Math.ceil(array.byteLength / 4) * 4;
  }
  function get<T>(name: string, kind: new (...parts: never[]) => T): T {
    const array = found.get(name);
    if (!(array instanceof kind)) throw new Error(`the frame holds no array ${name}`);
    return array;
  }
  return {
    header,
    arrays: {
      floats: (name) => get(name, Float32Array) as Float32Array,
      integers: (name) => get(name, Int32Array) as Int32Array,
      bytes: (name) => get(name, Uint8Array) as Uint8Array,
    },
  };
}
