// The door: what stands in the page's data is shown.

import { play } from "./player.js";
import { report } from "./report.js";

const data = JSON.parse(document.getElementById("data").textContent);
const place = document.createElement("main");
document.body.append(place);
const show = { replay: play, report };
show[data.kind](place, data).catch((error) => {
  console.error(error);
  place.textContent = `This page cannot be shown: ${error.message}`;
});
