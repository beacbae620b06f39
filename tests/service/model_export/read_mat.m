% Prints what a MATLAB file holds, one "NAME VALUE..." a line: numbers as the hexadecimal digits of
% their bits, texts as they are; and the outputs of a run of the model, whose inputs are in RUN.
arguments = argv();
file = load(arguments{1});
run = load(arguments{2});
for [value, name] = file
  if (ischar(value))
    printf("%s text %s\n", name, value);
  elseif (iscell(value))
    printf("%s cells %dx%d %s\n", name, rows(value), columns(value), strjoin(value', "|"));
  else
    printf("%s %dx%d %s\n", name, rows(value), columns(value),
           strjoin(cellstr(num2hex(value'(:)))', " "));
  end
end
x = file.x0;
for k = 1:rows(run)
  du = run(k, :)' - file.u0;
  y = file.C * x + file.D * du + file.y0;
  x = file.A * x + file.B * du;
  printf("run %s\n", strjoin(cellstr(num2hex(y))', " "));
end
