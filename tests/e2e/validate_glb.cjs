// SPDX-License-Identifier: Apache-2.0
// Prints the report of Khronos' glTF validator (npm package gltf-validator) for a file, as JSON.
// usage: node validate_glb.cjs FOLDER FILE; FOLDER is node_modules/gltf-validator
const fs = require('fs');
const path = require('path');
const [folder, file] = process.argv.slice(2);
const validator = require(path.resolve(folder));
validator.validateBytes(new Uint8Array(fs.readFileSync(file)), {maxIssues: 0}).then(
    (report) => console.log(JSON.stringify(report, null, 1)),
    (error) => { console.error(String(error)); process.exit(1); });
