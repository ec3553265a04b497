// The sum over the threads before this one, for all threads of a group: row by row, with two barriers. (A software
// device pays for every thread at every barrier.) Needs `sum_threads`, the number of threads in a group, and `sum_row`,
// the number of threads in a row.

shared uint sum_of_thread[sum_threads];
shared uint sum_of_row[sum_threads / sum_row];

uint sum_before(uint mine) {
  const uint thread = gl_LocalInvocationIndex;
  const uint row = thread / sum_row;
  sum_of_thread[thread] = mine;
  barrier();
  uint before = 0u;
  for (uint t = row * sum_row; t < thread; ++t) before += sum_of_thread[t];
  if (thread % sum_row == sum_row - 1u) sum_of_row[row] = before + mine;
  barrier();
  for (uint r = 0u; r < row; ++r) before += sum_of_row[r];
  return before;
}
