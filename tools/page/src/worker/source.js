/**
 * Bytes of a file, read by pages: of a file that the user chose, or of one that `tools/view` serves. The
 * HDF5 library reads in small pieces, and neither a file of a gigabyte nor its pages stay in memory.
 */

const PAGE = 1 << 18;
const MAX_PAGES = 192; // 48 MB
const READ_AHEAD = 4; // pages, where pages are read one after another

/** Reads bytes of a Blob. */
class BlobBytes {
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

/** Reads bytes from the server by range requests. */
class ServedBytes {
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
}

/** Pages of a file, the last used ones kept. Looks like a Blob to the file system of the HDF5 library. */
export class PagedFile {
  /** @param {{size: number, read(from: number, to: number): Uint8Array}} bytes */
  constructor(bytes) {
    this.bytes = bytes;
    this.size = bytes.size;
    this.lastModifiedDate = new Date(0);
    /** @type {Map<number, Uint8Array>} in the order of their use */
    this.pages = new Map();
    this.expected = -1;
    this.fault = undefined;
  }

  slice(from, to) {
    return { size: Math.max(0, Math.min(to, this.size) - from), read: () => this.read(from, Math.min(to, this.size)) };
  }

  read(from, to) {
    const out = new Uint8Array(to - from);
    for (let at = from; at < to;) {
      const number = Math.floor(at / PAGE);
      const page = this.page(number);
      const end = Math.min(to, (number + 1) * PAGE);
      out.set(page.subarray(at - number * PAGE, end - number * PAGE), at - from);
      at = end;
    }
    return out;
  }

  page(number) {
    const known = this.pages.get(number);
    if (known) {
      this.pages.delete(number);
      this.pages.set(number, known);
      return known;
    }
    this.load(number, number === this.expected ? READ_AHEAD : 1);
    return this.pages.get(number);
  }

  load(number, count) {
    const end = Math.min(this.size, (number + count) * PAGE);
    let block;
    try {
      block = this.bytes.read(number * PAGE, end);
    } catch (fault) {
      this.fault = fault; // the HDF5 library only reports that it could not read
      throw fault;
    }
    const pages = Math.ceil(block.length / PAGE);
    for (let i = pages - 1; i >= 0; --i) {
      this.pages.delete(number + i);
      this.pages.set(number + i, pages === 1 ? block : block.slice(i * PAGE, (i + 1) * PAGE));
    }
    this.expected = number + pages;
    while (this.pages.size > MAX_PAGES) this.pages.delete(this.pages.keys().next().value);
  }
}

/** @param {{blob?: Blob, url?: string, size?: number}} place */
export function pagedFile(place) {
  return new PagedFile(place.blob ? new BlobBytes(place.blob) : new ServedBytes(place.url, place.size));
}

/** FileReaderSync of the file system of the HDF5 library. */
export const pageReader = { readAsArrayBuffer: (piece) => piece.read().buffer };
