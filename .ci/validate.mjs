// Checks glTF files, .glb or .gltf with what they refer to, with the Khronos validator.
//
//   npm install --no-save gltf-validator@2.0.0-dev.3.10
//   node .ci/validate.mjs FILE...
//
// Prints one line for each file and every error and warning below it; exits with 1 if there is
// any, or if a file cannot be read, and with 2 if the validator is not installed. The validator
// is looked for where Node looks for packages, and in the folder that VALIDATOR_DIR names.

import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { dirname, join, resolve } from "node:path";

function loadValidator() {
  const places = [process.env.VALIDATOR_DIR, process.cwd()].filter(Boolean);
  for (const place of [...places.map((p) => resolve(p, "package.json")), import.meta.url]) {
    try {
      return createRequire(place)("gltf-validator");
    } catch (error) {
      if (error.code !== "MODULE_NOT_FOUND") throw error;
    }
  }
  console.error("validate: gltf-validator is not installed; run npm install gltf-validator");
  process.exit(2);
}

const files = process.argv.slice(2);
if (files.length === 0) {
  console.error("usage: node validate.mjs FILE...");
  process.exit(2);
}
const validator = loadValidator();
// Bark has a normal map and no tangents: the format has viewers make them, and four numbers more
// for each vertex would make a tree's file half as large again.
const ignoredIssues = ["MESH_PRIMITIVE_GENERATED_TANGENT_SPACE"];
// Severities 0 and 1 are errors and warnings; information and hints are not asked for.
const NAMES = ["error", "warning"];
let failed = false;
for (const file of files) {
  try {
    const bytes = new Uint8Array(await readFile(file));
    // What a .gltf refers to lies beside it, by a percent-encoded name.
    const externalResourceFunction = async (uri) =>
      new Uint8Array(await readFile(join(dirname(file), decodeURIComponent(uri))));
    const options = { uri: file, maxIssues: 0, ignoredIssues, externalResourceFunction };
    const report = await validator.validateBytes(bytes, options);
    const { numErrors, numWarnings, messages } = report.issues;
    const { totalVertexCount, totalTriangleCount } = report.info ?? {};
    const size = `${totalVertexCount ?? 0} vertices, ${totalTriangleCount ?? 0} triangles`;
    console.log(`${file}: ${numErrors} errors, ${numWarnings} warnings (${size})`);
    for (const { severity, code, message, pointer } of messages) {
      if (severity <= 1) console.log(`  ${NAMES[severity]} ${code} at ${pointer}: ${message}`);
    }
    failed ||= numErrors > 0 || numWarnings > 0;
  } catch (error) {
    console.log(`${file}: ${error.message ?? error}`);
    failed = true;
  }
}
process.exit(failed ? 1 : 0);
