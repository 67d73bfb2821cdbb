import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { PagedFile } from "../../../tools/page/src/worker/source.js";

const PAGE = 64;

/** Bytes that tell their place, and what was read of them. */
class Bytes {
  pageSize = PAGE;
  maxAhead = 0;
  readings = [];

  constructor(pages, maxRun) {
    this.size = pages * PAGE - 10; // the last page is not full
    this.maxRun = maxRun;
  }

  read(from, to) {
    this.readings.push([from / PAGE, Math.ceil(to / PAGE)]);
    return Uint8Array.from({ length: to - from }, (_, i) => (from + i) % 251);
  }
}

const expected = (from, to) => Uint8Array.from({ length: to - from }, (_, i) => (from + i) % 251);

describe("pages of a file", () => {
  it("have its bytes, whatever was read before", () => {
    const file = new PagedFile(new Bytes(40, 8));
    for (const [from, to] of [
      [0, 10],
      [60, 70],
      [0, file.size],
      [file.size - 5, file.size],
      [1000, 1300],
    ])
      assert.deepEqual(file.read(from, to), expected(from, to));
  });

  it("are read several at once where one is read behind the other", () => {
    const bytes = new Bytes(40, 8);
    const file = new PagedFile(bytes);
    for (let page = 0; page < 40; ++page) file.page(page);
    assert.deepEqual(bytes.readings, [
      [0, 1],
      [1, 3],
      [3, 7],
      [7, 15],
      [15, 23],
      [23, 31],
      [31, 39],
      [39, 40],
    ]);
  });

  it("are read several at once of several signals in turn", () => {
    const bytes = new Bytes(40, 4);
    const file = new PagedFile(bytes);
    for (let page = 0; page < 6; ++page) for (const signal of [0, 20]) file.page(signal + page);
    assert.deepEqual(bytes.readings, [
      [0, 1],
      [20, 21],
      [1, 3],
      [21, 23],
      [3, 7],
      [23, 27],
    ]);
  });

  it("are read one by one where they are apart", () => {
    const bytes = new Bytes(40, 8);
    const file = new PagedFile(bytes);
    for (let page = 0; page < 40; page += 7) file.page(page);
    assert.ok(bytes.readings.every(([from, to]) => to === from + 1));
  });
});
