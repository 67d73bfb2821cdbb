/** The page: puts its parts together and opens files. */
import { Page } from "./shell/page.js";

const page = new Page(document.getElementById("page"));
globalThis.servomill = page; // for tests, and for those who look under the bonnet
page.start();
