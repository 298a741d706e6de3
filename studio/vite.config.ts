// How the page is built: into the Python package, which serves it.
import react from "@vitejs/plugin-react";
import { defineConfig } from "vite";

export default defineConfig({
  plugins: [react()],
  build: {
    outDir: "../python/springform/studio/static",
    emptyOutDir: true,
    chunkSizeWarningLimit: 2000,
  },
});
