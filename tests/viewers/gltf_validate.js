// gltf_validate.js - what Khronos' validator says of glTF files: node gltf_validate.js FILE.glb...
//
// Prints a line for each file and each issue. Exit status 0; 1 for any error or warning; 2 when a file cannot be read or the
// module gltf-validator is not where NODE_PATH finds it.
'use strict';
const fs = require('fs');
const path = require('path');

async function main(files) {
  if (files.length === 0) throw new Error('usage: gltf_validate.js FILE.glb...');
  const validator = require('gltf-validator');
  let faults = 0;
  for (const file of files) {
    const read = (name) => new Uint8Array(fs.readFileSync(name));
    const { issues } = await validator.validateBytes(read(file), {
      uri: file, maxIssues: 100,
      externalResourceFunction: async (uri) => read(path.join(path.dirname(file), decodeURIComponent(uri))),
    });
    console.log(`${file}: ${issues.numErrors} errors, ${issues.numWarnings} warnings, ${issues.numInfos} infos, ` +
                `${issues.numHints} hints (gltf-validator ${validator.version()})`);
    for (const { code, message, pointer } of issues.messages) console.log(`  ${code} ${pointer || ''}: ${message}`);
    faults += issues.numErrors + issues.numWarnings;
  }
  return faults > 0 ? 1 : 0;
}

main(process.argv.slice(2)).then((status) => process.exit(status),
                                 (error) => { console.error(`gltf_validate: ${error.message}`); process.exit(2); });
