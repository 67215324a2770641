"""The command line: `pinograsp plan | why | check | rank | show | verify | assess | hold | robot | database | ...`.

One module for a command, a thin cover over the public API; `commands` brings them together. No module here imports a
library of robots, geometry or databases when it is loaded: `pinograsp` loads what a name needs when the name is used,
so that help and errors come at once. All commands write through `terminal`; `reporters` shows progress, `arguments`
holds the options that several commands have, `completion` what a shell may complete.
"""

from .commands import app, main

__all__ = ["app", "main"]
