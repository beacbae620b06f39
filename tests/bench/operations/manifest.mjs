// Checks the manifests of Kubernetes in a file against the schemas of their kinds, and prints them as
// JSON. Exits 1, with the mistake on standard error, where there is one.
import {readFileSync} from "node:fs";
import {parseAllDocuments} from "yaml";

const manifests = [];
for (const document of parseAllDocuments(readFileSync(process.argv[2], "utf8"))) {
  if (document.errors.length > 0) throw document.errors[0];
  const manifest = document.toJS();
  const models = await import(`kubernetes-models/${manifest.apiVersion}/${manifest.kind}`);
  new models[manifest.kind](manifest).validate();
  manifests.push(manifest);
}
console.log(JSON.stringify(manifests));
