/**
 * Bytes of a file, read by pages: of a file that the user chose, or of one that `tools/view` serves. The
 * HDF5 library reads in small pieces, and neither a file of a gigabyte nor its pages stay in memory.
 */

const KEPT = 80 << 20; // bytes of all pages
const STREAMS = 32; // places of the file from which reading on is expected

/**
 * Reads bytes of a Blob. Small pages leave the columns that nobody looks at unread: their chunks lie next to each other, in
 * older files about a megabyte apart. Every reading waits for another process, so what is read on is read at once.
 */
class BlobBytes {
  pageSize = 1 << 17;
  maxRun = 16; // pages that are read at once where one was read behind the other
  maxAhead = 0; // pages that are requested before they are needed

  constructor(blob) {
    this.size = blob.size;
    this.blob = blob;
    this.reader = new FileReaderSync();
  }

  read(from, to) {
    try {
      return new Uint8Array(this.reader.readAsArrayBuffer(this.blob.slice(from, to)));
    } catch {
      throw new Error("cannot be read: it was changed or removed after it was chosen; open it again");
    }
  }

}

/**
 * Reads bytes from the server by range requests. A request takes longer than its bytes: a large page holds the chunks of
 * several rows at little more time, and several at once take little longer than one.
 */
class ServedBytes {
  pageSize = 1 << 22;
  maxRun = 1;
  maxAhead = 8;

  constructor(url, size) {
    this.url = url;
    this.size = size;
  }

  read(from, to) {
    const request = new XMLHttpRequest();
    request.open("GET", this.url, false);
    request.responseType = "arraybuffer";
    request.setRequestHeader("Range", `bytes=${from}-${to - 1}`);
    try {
      request.send();
    } catch {
      throw new Error("cannot be read: tools/view does not run any more");
    }
    if (request.status === 410) throw new Error("was changed or removed; reload the page");
    if (request.status !== 206 || request.response.byteLength !== to - from) {
      throw new Error(`cannot be read: the server answered with status ${request.status}`);
    }
    return new Uint8Array(request.response);
  }

  /** The same without waiting. */
  async fetch(from, to) {
    const answer = await fetch(this.url, { headers: { Range: `bytes=${from}-${to - 1}` } });
    if (answer.status !== 206) throw new Error(`status ${answer.status}`);
    return new Uint8Array(await answer.arrayBuffer());
  }
}

/** Pages of a file, the last used ones kept. Looks like a Blob to the file system of the HDF5 library. */
export class PagedFile {
  /** @param {BlobBytes | ServedBytes} bytes */
  constructor(bytes) {
    this.bytes = bytes;
    this.size = bytes.size;
    this.pageSize = bytes.pageSize;
    this.lastModifiedDate = new Date(0);
    /** @type {Map<number, Uint8Array>} in the order of their use */
    this.pages = new Map();
    /** @type {Set<number>} pages that were needed since the last advance */
    this.needed = new Set();
    /** @type {Map<number, number>} pages behind those that were read last, and how many these were */
    this.runs = new Map();
    this.fault = undefined;
  }

  slice(from, to) {
    return { size: Math.max(0, Math.min(to, this.size) - from), read: () => this.read(from, Math.min(to, this.size)) };
  }

  read(from, to) {
    const out = new Uint8Array(to - from);
    for (let at = from; at < to;) {
      const number = Math.floor(at / this.pageSize);
      const page = this.page(number);
      const end = Math.min(to, (number + 1) * this.pageSize);
      out.set(page.subarray(at - number * this.pageSize, end - number * this.pageSize), at - from);
      at = end;
    }
    return out;
  }

  page(number) {
    this.needed.add(number);
    const known = this.pages.get(number);
    if (known) {
      this.pages.delete(number);
      this.pages.set(number, known);
      return known;
    }
    const count = this.runAt(number);
    const bytes = this.load(number, count);
    for (let i = count - 1; i > 0; --i) {
      if (!this.pages.has(number + i)) this.keep(number + i, bytes.slice(i * this.pageSize, (i + 1) * this.pageSize));
    }
    return this.keep(number, count > 1 ? bytes.slice(0, this.pageSize) : bytes);
  }

  /** Pages to be read at once: twice as many as those before them, if these were read last. */
  runAt(number) {
    const before = this.runs.get(number) ?? 0;
    const count = Math.max(1, Math.min(2 * before, this.bytes.maxRun, Math.ceil(this.size / this.pageSize) - number));
    this.runs.delete(number);
    this.runs.set(number + count, count);
    if (this.runs.size > STREAMS) this.runs.delete(this.runs.keys().next().value);
    return count;
  }

  keep(number, page) {
    this.pages.set(number, page);
    if (this.pages.size * this.pageSize > KEPT) this.pages.delete(this.pages.keys().next().value);
    return page;
  }

  /**
   * Called between the blocks of a column that is read from its begin to its end: requests as many pages as the last
   * block needed, behind it, all at once. Each of them would wait for the one before it if the library asked for it.
   */
  async advance() {
    const needed = [...this.needed];
    this.needed.clear();
    if (this.bytes.maxAhead === 0) return;
    const [first, last] = [Math.min(...needed), Math.max(...needed)];
    const count = Math.min(last - first + 1, this.bytes.maxAhead, Math.ceil(this.size / this.pageSize) - last - 1);
    const wanted = Array.from({ length: Math.max(0, count) }, (_, i) => last + 1 + i).filter((number) => !this.pages.has(number));
    await Promise.allSettled(
      wanted.map(async (number) => {
        const page = await this.bytes.fetch(number * this.pageSize, Math.min(this.size, (number + 1) * this.pageSize));
        if (!this.pages.has(number)) this.keep(number, page); // a fault shows when the page is needed
      }),
    );
  }

  load(number, count) {
    try {
      return this.bytes.read(number * this.pageSize, Math.min(this.size, (number + count) * this.pageSize));
    } catch (fault) {
      this.fault = fault; // the HDF5 library only reports that it could not read
      throw fault;
    }
  }
}

/** @param {{blob?: Blob, url?: string, size?: number}} place */
export function pagedFile(place) {
  return new PagedFile(place.blob ? new BlobBytes(place.blob) : new ServedBytes(place.url, place.size));
}

/** FileReaderSync of the file system of the HDF5 library. */
export const pageReader = { readAsArrayBuffer: (piece) => piece.read().buffer };
