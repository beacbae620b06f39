% octave_n4sid.m SAMPLES.csv INPUTS ORDER BLOCK_ROWS
% One identification by octave-control's n4sid of the columns u1.. y1.. (no header). Prints each
% matrix in a line: name, rows, columns, values by rows.
pkg load control
arguments = argv ();
samples = csvread (arguments{1});
inputs = str2double (arguments{2});
data = iddata (samples(:, inputs+1:end), samples(:, 1:inputs), 1);
model = n4sid (data, str2double (arguments{3}), "s", str2double (arguments{4}));
[A, B, C, D] = ssdata (model);
for part = {"A", A; "B", B; "C", C; "D", D}'
  matrix = part{2};
  printf ("%s %d %d%s\n", part{1}, rows (matrix), columns (matrix), sprintf (" %.17g", matrix'));
endfor
