import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { LongText } from "../../../tools/page/src/core/long_text.js";

const read = (text, page) => {
  const bytes = new TextEncoder().encode(text);
  const most = { bytes: 0 };
  const long = new LongText(
    bytes.length,
    (from, to) => {
      most.bytes = Math.max(most.bytes, to - from);
      return bytes.subarray(from, to);
    },
    page,
  );
  return { long, most };
};

describe("a long text", () => {
  it("has the lines that splitting it has, whatever the pages", () => {
    for (const text of ["G0 X1\nG1 Y2 (ä)\n\n\nM2\n", "one", "one\n", "\n", "(äöü)\n(€€€)\nN10 G1 X1 Y2 Z3 (longer than a page)\nM30"]) {
      const lines = text.split("\n");
      for (let page = 1; page <= 20; ++page) {
        const { long, most } = read(text, page);
        const found = lines.map((_, k) => long.line(k + 1));
        assert.deepEqual(found, lines, `${JSON.stringify(text)} in pages of ${page}`);
        assert.ok(most.bytes <= page);
      }
    }
  });

  it("has no other lines", () => {
    const { long } = read("one\ntwo", 2);
    for (const number of [0, -1, 3, NaN]) assert.equal(long.line(number), undefined);
    assert.equal(read("", 2).long.line(1), undefined);
  });
});
