/** Lines of a text too long to be split as a whole: a program of millions of lines. */

const NEWLINE = 10;

export class LongText {
  /**
   * @param {number} size bytes of the text, UTF-8
   * @param {(from: number, to: number) => Uint8Array} read
   * @param {number} page bytes that are read at once
   */
  constructor(size, read, page = 1 << 20) {
    Object.assign(this, { size, read, page });
  }

  pageOf(k) {
    return this.read(k * this.page, Math.min((k + 1) * this.page, this.size));
  }

  /** Newlines ahead of each page: a number a megabyte, while the places of all lines would take as much as the text. */
  get ahead() {
    if (!this.counts) {
      this.counts = [0];
      for (let k = 0; (k + 1) * this.page < this.size; ++k) {
        this.counts.push(this.counts[k] + this.pageOf(k).reduce((count, byte) => count + (byte === NEWLINE), 0));
      }
    }
    return this.counts;
  }

  /** Place of the first byte of a line, counted from 1; undefined behind the last one. */
  beginOf(number) {
    if (number === 1) return 0;
    const k = this.ahead.findLastIndex((count) => count < number - 1);
    const bytes = this.pageOf(k);
    let at = -1;
    for (let count = this.ahead[k]; count < number - 1; ++count) {
      at = bytes.indexOf(NEWLINE, at + 1);
      if (at < 0) return undefined;
    }
    return k * this.page + at + 1;
  }

  /** @returns {string | undefined} a line without its end, counted from 1; undefined behind the last one */
  line(number) {
    if (!(number >= 1) || this.size === 0) return undefined;
    const begin = this.beginOf(number);
    if (begin === undefined) return undefined;
    const decoder = new TextDecoder();
    let text = "";
    for (let k = Math.floor(begin / this.page); k * this.page < this.size; ++k) {
      const bytes = this.pageOf(k).subarray(Math.max(0, begin - k * this.page));
      const end = bytes.indexOf(NEWLINE);
      text += decoder.decode(end < 0 ? bytes : bytes.subarray(0, end), { stream: true });
      if (end >= 0) break;
    }
    return text + decoder.decode();
  }
}
