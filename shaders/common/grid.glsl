// SPDX-License-Identifier: Apache-2.0
// Places in a grid by number. Embedded GPUs divide integers slowly; the half keeps the quotient of
// floats away from whole numbers, for up to 2^21 places.

// Column and row of a number that counts row by row.
ivec2 place_in_grid(int number, int columns) {
  int row = int((float(number) + 0.5) / float(columns));
  return ivec2(number - row * columns, row);
}
