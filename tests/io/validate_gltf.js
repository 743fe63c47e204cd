// node validate_gltf.js MODULE FILE: fails if the Khronos validator has an error or a warning.
const fs = require('fs');
const [module_, file] = process.argv.slice(2);
require(module_).validateBytes(new Uint8Array(fs.readFileSync(file))).then((report) => {
  const bad = report.issues.messages.filter((message) => message.severity < 2);
  for (const message of bad) {
    console.error(`${message.code} ${message.pointer || ''}: ${message.message}`);
  }
  process.exit(bad.length > 0 ? 1 : 0);
}, (error) => {
  console.error(String(error));
  process.exit(1);
});
