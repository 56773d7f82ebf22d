"""Jobs in files, of whatever command: their tasks, files and receipts."""
import hashlib
import json
import os
import signal
from pathlib import Path


def phases(folder="job"):
    return [path.read_text().split() for path in sorted(Path(folder).glob("phase_*.txt"))]


def run(command, tasks, folder="job"):
    return command.done(f"job run {folder} " + " ".join(tasks))


def finish(command, folder="job"):
    run(command, [task for tasks in phases(folder) for task in tasks], folder)


def tiles(folder="job/tiles"):
    """The content of all files, by their paths from the folder on."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in Path(folder).rglob("*") if path.is_file()}


def sums(folder="job/tiles"):
    return {name: hashlib.sha256(content).hexdigest() for name, content in tiles(folder).items()}


def receipts(folder="job"):
    return {path.stem: path.read_bytes() for path in Path(folder, "done").glob("*.json")}


def forge(path, **changes):
    """A file of the job with other values and the right checksum, as another program of this name might have written it."""
    values = json.loads(Path(path).read_text())
    del values["check"]
    values.update(changes)
    for name in {"seconds", "processor_seconds"} & values.get("facts", {}).keys():
        values["facts"][name] = 0.5  # of a measured time the command may write a digit more than Python would
    text = json.dumps(values, indent=1, ensure_ascii=False)
    values["check"] = hashlib.sha256(text.encode()).hexdigest()
    Path(path).write_text(json.dumps(values, indent=1, ensure_ascii=False) + "\n")


def kill_session(started):
    """The engine and its tasks, in whatever groups it put them."""
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            number, rest = int(path.parts[2]), path.read_text().rpartition(")")[2].split()
            if int(rest[3]) == started.pid:
                os.kill(number, signal.SIGKILL)
        except OSError:
            pass
    started.wait()
