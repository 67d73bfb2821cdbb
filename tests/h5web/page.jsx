// H5Web on a file of the same server: /result.h5.
import { App } from '@h5web/app';
import { H5WasmBufferProvider } from '@h5web/h5wasm';
import { createRoot } from 'react-dom/client';

import '@h5web/app/styles.css';

const buffer = await (await fetch('/result.h5')).arrayBuffer();
createRoot(document.getElementById('root')).render(
  <H5WasmBufferProvider filename="result.h5" buffer={buffer}>
    <App />
  </H5WasmBufferProvider>,
);
