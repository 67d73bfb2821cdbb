// Keeps the library alive while its rooms fill.
