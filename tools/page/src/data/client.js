/** Requests to the worker that reads the files. */

/** Text of the worker, put in by the bundler: a page opened from file:// may not load a script of its own. */
const WORKER = /* global WORKER_SOURCE */ WORKER_SOURCE;

export class Client {
  /** @param {(progress: {done: number, total: number, what: string}) => void} onProgress */
  constructor(onProgress) {
    const url = URL.createObjectURL(new Blob([WORKER], { type: "text/javascript" }));
    this.worker = new Worker(url);
    this.waiting = new Map();
    this.isReady = false; // the library of the worker is compiled
    this.last = 0;
    this.onProgress = onProgress;
    this.worker.onmessage = ({ data }) => this.receive(data);
    this.worker.onerror = (event) => this.stop(`the reader of the files stopped: ${event.message}`);
  }

  receive({ id, result, fault, progress, ready }) {
    if (ready) {
      this.isReady = true;
      return;
    }
    if (progress) {
      this.onProgress(progress);
      return;
    }
    const { resolve, reject } = this.waiting.get(id);
    this.waiting.delete(id);
    if (fault === undefined) resolve(result);
    else reject(new Error(fault));
  }

  /** No request will be answered any more. */
  stop(why) {
    for (const { reject } of this.waiting.values()) reject(new Error(why));
    this.waiting.clear();
    this.onFault?.(why);
  }

  /** @returns {Promise<any>} what the method of the worker returns */
  ask(method, ...args) {
    const id = ++this.last;
    return new Promise((resolve, reject) => {
      this.waiting.set(id, { resolve, reject });
      this.worker.postMessage({ id, method, args });
    });
  }

  /** True while requests wait for their answers. */
  get busy() {
    return this.waiting.size > 0;
  }
}

/**
 * Of the requests made while one is under way, only the last one is made.
 * @template T
 * @param {(request: T) => Promise<void>} serve
 * @returns {(request: T) => Promise<void>}
 */
export function latestOnly(serve) {
  let running = false;
  let next;
  return async (request) => {
    next = { request };
    if (running) return;
    running = true;
    try {
      while (next) {
        const { request: current } = next;
        next = undefined;
        await serve(current);
      }
    } finally {
      running = false;
    }
  };
}
