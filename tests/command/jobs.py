"""Jobs in files, of whatever command: their tasks, files and receipts."""
import contextlib
import hashlib
import json
import os
import shutil
import signal
import subprocess
from pathlib import Path

from conftest import is_failure


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


def join_interrupted(command, task, output):
    """Ctrl-C as it has read the receipt of a task, which is a pipe for that long: the one sentence that it says then."""
    receipt = Path(f"job/done/{task}.json")
    whole = receipt.read_bytes()
    for _ in range(9):  # a busy machine may have all joined before the signal is sent
        receipt.unlink()
        os.mkfifo(receipt)
        with subprocess.Popen(command.words(f"job join job -o {output}"), stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              encoding="utf-8") as job:
            pipe = None
            while pipe is None and job.poll() is None:
                with contextlib.suppress(OSError):  # nobody reads it yet
                    pipe = os.open(receipt, os.O_WRONLY | os.O_NONBLOCK)
            receipt.unlink()
            receipt.write_bytes(whole)  # for who reads it again
            assert pipe is not None
            os.write(pipe, whole)
            os.close(pipe)
            job.send_signal(signal.SIGINT)
            out, err = job.communicate(timeout=60)
        if job.returncode != 0:
            break
        shutil.rmtree(output) if Path(output).is_dir() else Path(output).unlink()
    is_failure(subprocess.CompletedProcess(job.args, job.returncode, out, err), "interrupted")
    return err


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
