import { build } from "esbuild";
import { defineConfig, type Plugin } from "vite";
import en from "./src/messages/en.json";
import ru from "./src/messages/ru.json";
import uk from "./src/messages/uk.json";

declare const process: { env: Record<string, string | undefined> };
const server = "http://127.0.0.1:8642";
const languages: Record<string, Record<string, string>> = { en, uk, ru };

/** A text in every language; the style sheet shows that of the page. */
function inAll(key: string): string {
  const escaped = (text: string) => text.replaceAll("&", "&amp;").replaceAll("<", "&lt;");
  return Object.entries(languages)
    .map(([language, texts]) => {
      const text = texts[key];
      if (text === undefined) throw new Error(`index.html: no text ${key} in ${language}`);
      return `<span lang="${language}">${escaped(text)}</span>`;
    })
    .join("");
}

/** src/first.ts as a plain script, which the browser waits for before it draws. */
async function firstScript(): Promise<string> {
  const made = await build({ entryPoints: ["src/first.ts"], bundle: true, format: "iife", minify: true, target: "es2022", write: false });
  return made.outputFiles[0]!.text;
}

function shell(): Plugin {
  const file = "assets/first.js";
  return {
    name: "shell",
    transformIndexHtml: (html) => ({
      html: html.replace(/\s*<!--.*?-->/gs, "").replace(/%([a-z_.]+)%/g, (_, key: string) => inAll(key)),
      tags: [{ tag: "script", attrs: { src: `/${file}` }, injectTo: "head-prepend" }],
    }),
    async generateBundle() {
      this.emitFile({ type: "asset", fileName: file, source: await firstScript() });
    },
    configureServer(dev) {
      dev.middlewares.use(`/${file}`, (_, response) => {
        void firstScript().then((text) => response.setHeader("Content-Type", "text/javascript").end(text));
      });
    },
  };
}

/** A browser opens six connections to the server: what a run needs is two files, not ten. */
function chunkOf(id: string): string | undefined {
  if (/\/src\/(main|api|begun|choice|dom|i18n|reasons|streams|pages\/(badge|progress))\.ts$|messages\/en\.json|node_modules\/(@formatjs|intl-|tslib)|preload-helper/.test(id)) return "main";
  if (id.includes("node_modules/three")) return "three";
  if (id.includes("node_modules/uplot/dist/uPlot.esm") || (id.includes("/src/plots/") && !id.endsWith("/space.ts"))) return "plots";
  const views = "attitude|document|ensemble|events|facts|gravity|noise|overview|quality|run|signaldata|signals|sky|track|values|views";
  return new RegExp(`/src/pages/(${views})\\.ts$`).test(id) ? "run" : undefined;
}

export default defineConfig({
  base: "/",
  plugins: [shell()],
  build: {
    target: "es2022",
    modulePreload: false,
    assetsInlineLimit: 0,
    cssCodeSplit: false,
    // names without digests: browsers ask each time whether what they have is still that of the server
    rollupOptions: {
      output: {
        entryFileNames: "assets/[name].js",
        chunkFileNames: "assets/[name].js",
        assetFileNames: "assets/[name][extname]",
        manualChunks: chunkOf,
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
