"""Rules for the words of pages and comments. Prints each breach as file:line: message.

  - a sentence of a page has at most 30 words; tables, headings and code do not count
  - pages and comments use the field's terms: the words of AVOIDED have a plain replacement
  - a comment does not begin with "Of", "That" or "The same"

Code between backticks is not prose: names of outcomes and options stay what they are.

usage: check_words.py ROOT [--pages | FILE...]     (all tracked files without FILE)
"""

import re
import subprocess
import sys
from pathlib import Path

MAX_SENTENCE_WORDS = 30
AVOIDED = {
    r"surely": "with 99 % confidence; the lower confidence bound",
    r"beside": "compared with, next to, in addition to",
    r"tell|tells|told|telling": "shows, reports, distinguishes",
    r"anew": "again",
    r"astray": "diverges",
    r"vouch(?:es|ed|ing)?|unvouched": "confirmed by a redundant sensor",
    r"a word of": "a decision of",
    r"liars?|lying": "sensor faults, fault injector",
}
AVOIDED = [(re.compile(rf"\b(?:{words})\b", re.IGNORECASE), use) for words, use in AVOIDED.items()]
BEGINNING = re.compile(r"(?:Of|That|The same)\b")
ABBREVIATIONS = re.compile(r"\b(e\.g|i\.e|etc|vs|Fig|Eq|cf|No|al)\.")


def tracked_files(root):
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=root,
                            capture_output=True, text=True)
    names = listed.stdout.splitlines() if listed.returncode == 0 else [
        str(path.relative_to(root)) for path in root.rglob("*") if path.is_file()
        and not {"build", ".git"} & set(path.relative_to(root).parts)]
    return [name for name in names if (root / name).is_file()]


def blocks_of_page(lines):
    """(line number, text) of each paragraph and list item."""
    block, start, fenced = [], 0, False
    for number, line in enumerate(lines + [""], 1):
        if line.lstrip().startswith("```"):
            fenced = not fenced
            line = ""
        elif fenced or line.lstrip().startswith(("|", "#", "!", "<")) or line.startswith("    "):
            line = ""
        begins = re.match(r"\s*(?:[-*]|\d+\.) ", line)
        if block and (not line.strip() or begins):
            yield start, " ".join(block)
            block = []
        if line.strip():
            if not block:
                start = number
            block.append(re.sub(r"^\s*(?:[-*]|\d+\.) +", "", line).strip())


def prose(text):
    """Without code, links' addresses and emphasis."""
    text = re.sub(r"`[^`]*`", "code", text)
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)
    return text.replace("**", "").replace("*", "")


def sentences(text):
    text = ABBREVIATIONS.sub(lambda match: match[1], text)
    return re.split(r"(?<=[.!?:;])[\"')]*\s+(?=[\"'(A-Z0-9])", text)


def check_page(lines):
    for number, block in blocks_of_page(lines):
        for sentence in sentences(prose(block)):
            words = [word for word in sentence.split() if re.search(r"\w", word)]
            if len(words) > MAX_SENTENCE_WORDS:
                yield number, f"a sentence of {len(words)} words: {' '.join(words[:8])} ..."
    fenced = False
    for number, line in enumerate(lines, 1):
        if line.lstrip().startswith("```"):
            fenced = not fenced
        if not fenced:
            yield from avoided(number, prose(line))


def avoided(number, text):
    for pattern, use in AVOIDED:
        if match := pattern.search(text):
            yield number, f'"{match[0]}": {use}'


def comments_of_code(name, lines):
    """(line number, text, whether the comment begins there)."""
    mark = r"#(?!!)" if name.endswith((".py", ".sh", ".txt", ".toml")) else r"//[/!]?<?"
    before = False
    for number, line in enumerate(lines, 1):
        whole = re.match(rf"\s*{mark}(.*)", line)
        trailing = None if whole else re.search(rf"\s{{2,}}{mark} (.*)", line)
        if found := whole or trailing:
            yield number, found[1].strip(), not (whole and before)
        before = bool(whole) and bool(whole[1].strip())


def check_comments(name, lines):
    for number, text, begins in comments_of_code(name, lines):
        if begins and BEGINNING.match(text):
            yield number, f'a comment begins with "{BEGINNING.match(text)[0]}"'
        yield from avoided(number, re.sub(r"`[^`]*`", "code", text))


def main():
    root = Path(sys.argv[1])
    names = sys.argv[2:] or tracked_files(root)
    if names == ["--pages"]:
        names = [name for name in tracked_files(root) if name.endswith(".md")]
    breaches = []
    for name in names:
        page = name.endswith(".md")
        if not page and not name.endswith((".cpp", ".hpp", ".c", ".h", ".py", ".sh", ".txt", ".toml")):
            continue
        if name.endswith("check_words.py"):
            continue
        lines = (root / name).read_text(encoding="utf-8").splitlines()
        found = check_page(lines) if page else check_comments(name, lines)
        breaches += [f"{name}:{number}: {message}" for number, message in found]
    print("\n".join(breaches) if breaches else f"{len(names)} files keep the rules")
    return 1 if breaches else 0


if __name__ == "__main__":
    sys.exit(main())
