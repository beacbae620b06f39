/* The model, and the file resources/model.txt that holds it:
 *
 *   reident-fmu-model 2
 *   digest D              SHA-256 of the published model; the FMU's guid or token
 *   period T              seconds between two ticks
 *   order n  inputs m  outputs p  parameters q
 *   start                 q numbers: the parameters before any was set
 *   state                 n numbers: x before it was set
 *   A B C D u0 y0         n n, n m, p n, p m, m, p numbers, matrices row by row
 *   input COUNT           m times: the steps of its program (postfix.h), over the q parameters
 *   checksum S            16 hexadecimal digits: FNV-1a of all bytes before this line
 *
 * Words are separated by blanks and line ends. Numbers are hexadecimal as C writes them by %a, so
 * that the bits come back in every locale.
 */
#ifndef REIDENT_MODEL_FILE_H
#define REIDENT_MODEL_FILE_H

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "bytes.h"
#include "postfix.h"

/* Bounds of what is accepted, so that a damaged file cannot ask for all memory. */
enum {
  model_digest_length = 64,
  model_most_signals = 10000,
  model_most_steps = 1000,
  model_most_bytes = 256 * 1024 * 1024
};

/* How an input follows from the parameters (postfix.h). */
typedef struct {
  PostfixStep* steps;
  size_t count;
} Program;

/* What the file holds. It owns `numbers` and `programs`. Constant once it was read. */
typedef struct {
  char digest[model_digest_length + 1];
  double period_s;
  size_t order, inputs, outputs, parameters;
  const double *start, *state, *A, *B, *C, *D, *u0, *y0; /* in `numbers` */
  double* numbers;
  Program* programs; /* one for each input */
} Model;

/* Frees what the model owns; also of one that is all 0. */
static void model_free(Model* model) {
  if (model->programs != NULL)
    for (size_t i = 0; i < model->inputs; ++i) free(model->programs[i].steps);
  free(model->programs);
  free(model->numbers);
}

/* What is left of the text. The first mistake stays, and sizes that are read after it are 0, so
 * that readers need not look at each step. */
typedef struct {
  const char* at;
  const char* end;
  const char* mistake; /* NULL as long as all was right; what was wrong first */
} Words;

typedef struct {
  const char* at;
  size_t length;
} Word;

static void words_refuse(Words* words, const char* mistake) {
  if (words->mistake == NULL) words->mistake = mistake;
}

static int is_blank(char c) {
  return c == ' ' || c == '\n' || c == '\r' || c == '\t';
}

/* Returns the next word; one without length at the end. */
static Word next_word(Words* words) {
  while (words->at < words->end && is_blank(*words->at)) ++words->at;
  Word word = {words->at, 0};
  while (words->at < words->end && !is_blank(*words->at)) ++words->at;
  word.length = (size_t)(words->at - word.at);
  return word;
}

static int word_is(Word word, const char* text) {
  return strlen(text) == word.length && memcmp(text, word.at, word.length) == 0;
}

/* Steps over the word that has to come next. */
static void expect_word(Words* words, const char* text) {
  if (!word_is(next_word(words), text)) words_refuse(words, "an entry is missing or misplaced");
}

/* Whether the word is a whole number of at most 9 digits and not above `most`; then sets
 * `value`. */
static int whole_of(Word word, size_t most, size_t* value) {
  if (word.length == 0 || word.length > 9) return 0;
  *value = 0;
  for (size_t i = 0; i < word.length; ++i) {
    if (word.at[i] < '0' || word.at[i] > '9') return 0;
    *value = 10 * *value + (size_t)(word.at[i] - '0');
  }
  return *value <= most;
}

/* Returns the size behind the word `name`. */
static size_t next_size(Words* words, const char* name, size_t most) {
  size_t value = 0;
  expect_word(words, name);
  if (!whole_of(next_word(words), most, &value)) words_refuse(words, "a size is none");
  return words->mistake == NULL ? value : 0;
}

static int hexadecimal_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return -1;
}

/* Reads hexadecimal digits at `*at` into the bits of `mantissa`; how many there were. */
static int take_digits(const char** at, const char* end, uint64_t* mantissa) {
  int count = 0;
  for (; *at < end && hexadecimal_digit(**at) >= 0 && count <= 16; ++*at, ++count)
    *mantissa = *mantissa << 4 | (uint64_t)hexadecimal_digit(**at);
  return count;
}

/* Whether the word is [-]0xH[.HHH]p(+|-)DDD and finite; then sets `value` to it exactly. strtod
 * would ask the locale for its decimal point. */
static int real_of(Word word, double* value) {
  const char* at = word.at;
  const char* const end = word.at + word.length;
  const int negative = at < end && *at == '-';
  if (negative) ++at;
  if (end - at < 2 || at[0] != '0' || at[1] != 'x') return 0;
  at += 2;
  uint64_t mantissa = 0;
  int digits = take_digits(&at, end, &mantissa), fraction = 0;
  if (digits == 0) return 0;
  if (at < end && *at == '.') {
    ++at;
    fraction = take_digits(&at, end, &mantissa);
  }
  if (digits + fraction > 15 || end - at < 3 || *at++ != 'p') return 0;
  const int below_one = *at == '-';
  if (!below_one && *at != '+') return 0;
  ++at;
  size_t exponent = 0;
  if (!whole_of((Word){at, (size_t)(end - at)}, 1100, &exponent)) return 0;
  const double size =
      ldexp((double)mantissa, (below_one ? -(int)exponent : (int)exponent) - 4 * fraction);
  *value = negative ? -size : size;
  return isfinite(size);
}

static double next_real(Words* words) {
  double value = 0;
  if (!real_of(next_word(words), &value)) words_refuse(words, "a number is none");
  return value;
}

/* Reads `count` numbers behind the word `name` to `at`, notes in `where` that they are there, and
 * returns the place behind them. */
static double* next_reals(Words* words, const char* name, double* at, size_t count,
                          const double** where) {
  expect_word(words, name);
  *where = at;
  for (size_t i = 0; i < count && words->mistake == NULL; ++i) *at++ = next_real(words);
  return at;
}

/* Reads a step: a number, pN for parameter N, or the word of an operation. */
static void read_step(Words* words, size_t parameters, PostfixStep* step) {
  const Word word = next_word(words);
  step->kind = postfix_kind(word.at, word.length);
  if (step->kind != postfix_number) return;
  const Word rest = {word.at + 1, word.length - 1};
  if (word.length > 1 && word.at[0] == 'p') {
    step->kind = postfix_variable;
    if (!whole_of(rest, parameters, &step->variable) || step->variable == parameters)
      words_refuse(words, "an input names a parameter that is none");
  } else if (!real_of(word, &step->number)) {
    words_refuse(words, "an input has a step that is none");
  }
}

static void read_program(Words* words, size_t parameters, Program* program) {
  const size_t count = next_size(words, "input", model_most_steps);
  if (words->mistake != NULL) return;
  program->steps = calloc(count + 1, sizeof *program->steps);
  if (program->steps == NULL) {
    words_refuse(words, "there is no memory for an input");
    return;
  }
  program->count = count;
  for (size_t i = 0; i < count && words->mistake == NULL; ++i)
    read_step(words, parameters, &program->steps[i]);
  if (words->mistake == NULL && !postfix_is_sound(program->steps, program->count))
    words_refuse(words, "an input's program does not leave one value");
}

static void read_matrices(Words* words, Model* model) {
  const size_t n = model->order, m = model->inputs, p = model->outputs, q = model->parameters;
  double* at = model->numbers;
  at = next_reals(words, "start", at, q, &model->start);
  at = next_reals(words, "state", at, n, &model->state);
  at = next_reals(words, "A", at, n * n, &model->A);
  at = next_reals(words, "B", at, n * m, &model->B);
  at = next_reals(words, "C", at, p * n, &model->C);
  at = next_reals(words, "D", at, p * m, &model->D);
  at = next_reals(words, "u0", at, m, &model->u0);
  next_reals(words, "y0", at, p, &model->y0);
}

static void read_head(Words* words, Model* model) {
  expect_word(words, "reident-fmu-model");
  if (!word_is(next_word(words), "2"))
    words_refuse(words,
                 "its format is not 2: the FMU's binary and resources do not belong together");
  expect_word(words, "digest");
  const Word digest = next_word(words);
  if (digest.length != model_digest_length) {
    words_refuse(words, "its digest is none");
    return;
  }
  memcpy(model->digest, digest.at, digest.length);
  expect_word(words, "period");
  model->period_s = next_real(words);
  if (!(model->period_s > 0)) words_refuse(words, "its period is not above 0");
  model->order = next_size(words, "order", model_most_signals);
  model->inputs = next_size(words, "inputs", model_most_signals);
  model->outputs = next_size(words, "outputs", model_most_signals);
  model->parameters = next_size(words, "parameters", model_most_signals);
}

/* Returns the length of `text` without its last line, where that is the checksum of what is before
 * it; else 0. */
static size_t checked_length(const char* text, size_t length) {
  const char key[] = "checksum ";
  const size_t line = sizeof key - 1 + 16 + 1;
  if (length < line || text[length - 1] != '\n') return 0;
  const size_t before = length - line;
  if (memcmp(text + before, key, sizeof key - 1) != 0) return 0;
  const char* at = text + before + sizeof key - 1;
  uint64_t stated = 0;
  if (take_digits(&at, text + length - 1, &stated) != 16) return 0;
  return stated == bytes_checksum((const unsigned char*)text, before) ? before : 0;
}

/* Reads a text into a model that is all 0. Returns what is wrong with it, or NULL. The model is to
 * be freed either way. */
static const char* model_parse(const char* text, size_t length, Model* model) {
  const size_t checked = checked_length(text, length);
  if (checked == 0) return "it is damaged: its checksum does not match its content";
  Words words = {text, text + checked, NULL};
  read_head(&words, model);
  if (words.mistake != NULL) return words.mistake;
  const size_t n = model->order, m = model->inputs, p = model->outputs;
  const size_t numbers = (n + p) * (n + m) + n + m + p + model->parameters;
  /* No number takes less than a blank and 0x0p+0. */
  if (numbers > checked / 7) return "it holds fewer numbers than its sizes say";
  model->numbers = calloc(numbers + 1, sizeof *model->numbers);
  model->programs = calloc(m + 1, sizeof *model->programs);
  if (model->numbers == NULL || model->programs == NULL) return "there is no memory for it";
  read_matrices(&words, model);
  for (size_t i = 0; i < m && words.mistake == NULL; ++i)
    read_program(&words, model->parameters, &model->programs[i]);
  if (words.mistake == NULL && next_word(&words).length > 0)
    words_refuse(&words, "more follows than its sizes say");
  return words.mistake;
}

/* Returns the whole file, to be freed; NULL where it cannot be read or has more than
 * model_most_bytes. */
static char* file_content(const char* path, size_t* length) {
  FILE* file = fopen(path, "rb");
  if (file == NULL) return NULL;
  char* content = NULL;
  long size = -1;
  if (fseek(file, 0, SEEK_END) == 0) size = ftell(file);
  if (size >= 0 && size <= model_most_bytes && fseek(file, 0, SEEK_SET) == 0)
    content = malloc((size_t)size + 1);
  if (content != NULL && fread(content, 1, (size_t)size, file) != (size_t)size) {
    free(content);
    content = NULL;
  }
  fclose(file);
  *length = content == NULL ? 0 : (size_t)size;
  return content;
}

/* Reads the model. Returns what is wrong with the file, or NULL; the model is to be freed either
 * way. */
static const char* model_read(const char* path, Model* model) {
  memset(model, 0, sizeof *model);
  size_t length = 0;
  char* const text = file_content(path, &length);
  if (text == NULL) return "it cannot be read; is the FMU unpacked whole?";
  const char* const mistake = model_parse(text, length, model);
  free(text);
  return mistake;
}

#endif
