// SPDX-License-Identifier: GPL-3.0-or-later
// validate_glb.js FILE...: what the Khronos validator says, one line a file; exit 1 where a file has an error.
// The module gltf-validator is looked for where Node looks, NODE_PATH included.
"use strict";
const fs = require("fs");
const validator = require("gltf-validator");

async function main(files) {
  let failed = 0;
  for (const file of files) {
    const bytes = new Uint8Array(fs.readFileSync(file));
    const { issues } = await validator.validateBytes(bytes, { uri: file, maxIssues: 0 });
    console.log(`${file}: ${issues.numErrors} errors, ${issues.numWarnings} warnings, ${issues.numInfos} infos`);
    // Severity 0 is an error, 1 a warning; each code once, with the first place it was seen at.
    const seen = new Map();
    for (const message of issues.messages) {
      if (message.severity > 1) continue;
      const known = seen.get(message.code);
      if (known) known.count += 1;
      else seen.set(message.code, { ...message, count: 1 });
    }
    for (const m of seen.values()) {
      console.log(`  ${m.severity === 0 ? "ERROR" : "warning"} ${m.code} x${m.count} ${m.pointer || ""}: ${m.message}`);
    }
    if (issues.numErrors > 0) failed += 1;
  }
  return failed === 0 ? 0 : 1;
}

main(process.argv.slice(2)).then((code) => process.exit(code), (error) => {
  console.error(error);
  process.exit(1);
});
