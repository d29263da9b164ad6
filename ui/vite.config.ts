import { defineConfig } from "vite";

declare const process: { env: Record<string, string | undefined> };
const server = "http://127.0.0.1:8642";

export default defineConfig({
  base: "/",
  build: {
    target: "es2022",
    modulePreload: false,
    assetsInlineLimit: 0,
    // names without digests: the server tells browsers to keep nothing
    rollupOptions: {
      output: {
        entryFileNames: "assets/[name].js",
        chunkFileNames: "assets/[name].js",
        assetFileNames: "assets/[name][extname]",
        manualChunks: (id) => (id.includes("node_modules/three") ? "three" : undefined),
      },
    },
    chunkSizeWarningLimit: 900,
  },
  // `schuler ui` at its usual port answers; it takes no requests from pages of other origins, and none without the token that it printed
  server: {
    proxy: {
      "/api": {
        target: server,
        changeOrigin: true,
        headers: { origin: server, authorization: `Bearer ${process.env.SCHULER_TOKEN ?? ""}` },
      },
    },
  },
});
