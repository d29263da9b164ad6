"""The commands of the program as functions, made of its own table of options."""
import inspect
import keyword
import os

from . import _schuler
from ._error import Error
from ._result import Result, temporary_folder

COMMANDS = {command["name"]: command for command in _schuler.commands()}
SETTINGS = {option["key"]: option for option in _schuler.setting_options()}
_GENERAL = {
    "settings": "dict: settings of dataset.toml, {\"imu.grade\": \"mems\"} or {\"imu\": {\"grade\": \"mems\"}}, over all others",
    "progress": "called with the share done, from 0 to 1",
    "threads": "int: maximum number of threads; results do not depend on it. 0: one for each processor core",
    "force": "bool: overwrite files at the place of the results even if another program wrote them",
}


def argument_of(key):
    """The name of an option as a keyword: self-check is self_check, gnss.latency_s is gnss_latency_s."""
    name = key.replace("-", "_").replace(".", "_")
    return name + "_" if keyword.iskeyword(name) else name


def takes_settings(command):
    return any(option["key"] == "set" for option in command["options"])


def keywords_of(command):
    """keyword -> key of an option of the command, or of a setting where it takes settings."""
    own = {argument_of(option["key"]): ("option", option["key"]) for option in command["options"] if option["key"] != "set"}
    if not takes_settings(command):
        return own
    names = [argument_of(key) for key in SETTINGS]
    return {argument_of(key): ("setting", key) for key in SETTINGS if names.count(argument_of(key)) == 1} | own


def _outage(value):
    """Outages as T:DUR; pairs of numbers too."""
    items = [value] if isinstance(value, str) or (len(value) == 2 and not hasattr(value[0], "__len__")) else value
    return [item if isinstance(item, str) else f"{item[0]}:{item[1]}" for item in items]


def given_of(command, arguments, keywords):
    """What the program is given: key -> value. Checks every name."""
    positional = [option["key"] for option in command["options"] if option["positional"]]
    if len(arguments) > len(positional):
        raise Error.of(f"takes {len(positional)} arguments without a name, and {len(arguments)} are given", command["name"],
                       f"they are {', '.join(positional)}" if positional else "give options by their names")
    known = keywords_of(command)
    shapes = {option["key"]: option["shape"] for option in command["options"]}
    given = dict(zip(positional, arguments))
    settings = dict(keywords.pop("settings", None) or {})
    if settings and not takes_settings(command):
        raise Error.of("it takes no settings", command["name"])
    above = list(_schuler.setting_keys(settings)) if settings else []
    for name, value in keywords.items():
        if name not in known:
            near = _schuler.nearest_key(name, [*known, *_GENERAL])
            raise Error.of("unknown keyword", name, f"did you mean {near}?" if near else f"see help(schuler.{command['name'].replace(' ', '.')})")
        kind, key = known[name]
        if value is None:
            continue
        if kind == "setting":
            above.append((key, value))
        elif key in given:
            raise Error.of("is given twice", name)
        else:
            given[key] = _outage(value) if key == "outage" and shapes[key] == "texts" else value
    if above:
        given["set"] = [_schuler.setting_text(key, value) for key, value in above]
    for option in command["options"]:
        if option["required"] and option["key"] not in given and option["key"] != "output":
            raise Error.of("is missing", argument_of(option["key"]), option["help"])
    return {key: os.fspath(value) if hasattr(value, "__fspath__") else value for key, value in given.items()}


def perform(name, arguments, keywords):
    command = COMMANDS[name]
    general = {key: keywords.pop(key) for key in ("progress", "threads", "force") if key in keywords}
    given = given_of(command, arguments, dict(keywords))
    options = {option["key"]: option for option in command["options"]}
    temporary = None
    if "output" in options and "output" not in given and options["output"]["otherwise"] != "none":
        temporary = temporary_folder()
        given["output"] = str(temporary / "result")
        if "outputs" in options:    # what arrays are made of; a report that nobody sees is not drawn
            given.setdefault("outputs", ["solution"] if name == "ahrs" else ["summary", "h5"])
    outcome = _schuler.perform(name, given, **{k: v for k, v in general.items() if v is not None})
    return Result(name, outcome, temporary)


def _document(command, options):
    lines = [command["purpose"][:1].upper() + command["purpose"][1:] + ".", ""]
    for option in options:
        unit = f", {option['unit']}" if option["unit"] else ""
        default = option["otherwise"] or (option["default"] if option["default"] is not None else "")
        lines.append(f"{argument_of(option['key'])}: {option['accepts']}{unit}{f' [{default}]' if default != '' else ''}")
        lines.append(f"    {option['help']}")
    for name, text in _GENERAL.items():
        if name != "settings" or takes_settings(command):
            lines += [f"{name}", f"    {text}"]
    if takes_settings(command):
        lines += ["", "Settings of dataset.toml are keywords too: gnss_latency_s is gnss.latency_s. docs/options.md lists them."]
    if any(option["key"] == "output" for option in options):
        lines += ["", "Without `output` the files are in a temporary folder that goes with the result."]
    lines += ["", "Returns a schuler.Result. Raises schuler.Error; KeyboardInterrupt ends a computation that shows its progress."]
    return "\n".join(lines)


def function_of(name, qualified=None):
    """A function of the package for a command of the program."""
    command = COMMANDS[name]
    options = [option for option in command["options"] if option["key"] != "set"]

    def call(*arguments, **keywords):
        return perform(name, arguments, keywords)

    kinds = inspect.Parameter
    parameters = [kinds(argument_of(o["key"]), kinds.POSITIONAL_OR_KEYWORD, default=kinds.empty if o["required"] else None)
                  for o in options if o["positional"]]
    parameters += [kinds(argument_of(o["key"]), kinds.KEYWORD_ONLY, default=None) for o in options if not o["positional"]]
    general = [g for g in _GENERAL if g != "settings" or takes_settings(command)]
    parameters += [kinds(g, kinds.KEYWORD_ONLY, default=None) for g in general]
    if takes_settings(command):
        parameters.append(kinds("keywords", kinds.VAR_KEYWORD))
    call.__signature__ = inspect.Signature(parameters)
    call.__name__ = call.__qualname__ = qualified or name
    call.__module__ = "schuler"
    call.__doc__ = _document(command, options)
    return call
