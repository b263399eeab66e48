"""The errors that a user can cause, with the exit code each one ends in."""


class InputError(Exception):
    """Bad input; carries every message found at once. Exit code 2."""

    def __init__(self, messages):
        self.messages = [messages] if isinstance(messages, str) else list(messages)
        super().__init__("\n".join(self.messages))


class RunError(Exception):
    """A run that has gone wrong in its physics; the message says where and what may help. Exit code 1."""


class WriteError(Exception):
    """A file or folder that cannot be written. Exit code 74."""

    def __init__(self, path, reason):
        self.path, self.reason = path, reason
        super().__init__(path, reason)  # so that it can be sent from rank to rank

    def __str__(self):
        return f"cannot write {self.path}: {self.reason}"
