// Makes suite/show/web/suite.js, the one script of every page, and says in it of which sources it is made.

import { createHash } from "node:crypto";
import { copyFileSync, readdirSync, readFileSync } from "node:fs";
import { build } from "esbuild";

const out = "../suite/show/web";
const digest = createHash("sha256");
for (const name of [...readdirSync(".").filter((each) => each.endsWith(".js")), "package-lock.json"].sort())
  digest.update(readFileSync(name));
await build({
  entryPoints: ["main.js"],
  bundle: true,
  minify: true,
  format: "iife",
  target: "es2022",
  legalComments: "none", // the licence stands in the page, once
  banner: { js: `/* of the sources ${digest.digest("hex").slice(0, 16)} */` },
  outfile: `${out}/suite.js`,
});
if (/<\/script|<!--/i.test(readFileSync(`${out}/suite.js`, "utf8")))
  throw new Error("suite.js would end its own element");
copyFileSync("node_modules/three/LICENSE", `${out}/THREE-LICENSE`);
