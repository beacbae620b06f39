"""What `helm template` makes of a chart that uses range, if, toJson and sha256sum alone."""

import hashlib
import json
import re

FUNCTIONS = {"toJson": lambda value: json.dumps(value, sort_keys=True, separators=(",", ":")),
             "sha256sum": lambda text: hashlib.sha256(text.encode()).hexdigest()}


def value_of(expression, here, root):
    function, _, path = expression.rpartition(" ")
    value = root if path.startswith("$") else here
    for name in path.lstrip("$").split(".")[1:]:
        value = value.get(name)
    return FUNCTIONS[function](value) if function else value


def rendered(text, values):
    """The text of a template."""
    root = {"Values": values}
    text = re.sub(r"\s*\{\{-", "{{", text)
    parts = re.split(r"\{\{\s*(.*?)\s*\}\}", text)  # text and actions in turn

    def walk(at, here, out):
        """Writes until the end of the block, nothing where out is None; returns where that is."""
        while at + 1 < len(parts):
            if out is not None:
                out.append(parts[at])
            action, at = parts[at + 1], at + 2
            word, _, rest = action.partition(" ")
            if word == "end":
                return at
            if word not in ("range", "if"):
                if out is not None:
                    out.append(str(value_of(action, here, root)))
                continue
            value = out is not None and value_of(rest, here, root)
            end = walk(at, here, None)
            for item in value or [] if word == "range" else [here] * bool(value):
                walk(at, item, out)
            at = end
        if out is not None:
            out.append(parts[at])
        return at

    out = []
    walk(0, root, out)
    return "".join(out)
