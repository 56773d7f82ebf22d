"""What a program shows on a terminal: it is given one end of a pseudo terminal, and the other is read here."""
import fcntl
import os
import pty
import struct
import subprocess
import termios


def shown(words, columns=0, environment=None, shows_output=False):
    """What a program writes to the standard error, a terminal of this width, 0: it does not say: its status and the bytes. Its
    standard output is the same terminal or goes nowhere."""
    ours, its = pty.openpty()
    fcntl.ioctl(its, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
    with subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=its if shows_output else subprocess.DEVNULL, stderr=its,
                          env={**os.environ, **(environment or {})}) as run, \
         open(ours, "rb", buffering=0) as terminal:
        os.close(its)
        printed = b""
        try:
            while more := terminal.read(4096):
                printed += more
        except OSError:  # nobody writes any more
            pass
    return run.returncode, printed
