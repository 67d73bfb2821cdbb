/**
 * Bytes of a file, read by pages: of a file that the user chose, or of one that `tools/view` serves. The
 * HDF5 library reads in small pieces, and neither a file of a gigabyte nor its pages stay in memory.
 */

const KEPT = 80 << 20; // bytes of all pages

/**
 * Reads bytes of a Blob. The chunks of a column lie about a megabyte apart, those of other columns between them: small
 * pages leave most of the file unread, and each is there as soon as it is asked for.
 */
class BlobBytes {
  pageSize = 1 << 17;
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
    return this.keep(number, this.load(number));
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

  load(number) {
    try {
      return this.bytes.read(number * this.pageSize, Math.min(this.size, (number + 1) * this.pageSize));
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
