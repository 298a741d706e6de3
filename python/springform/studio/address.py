"""The studio's address: the same after a restart, so that a window left open finds it again."""

from __future__ import annotations

import json
import os
import secrets
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from ..errors import InputError
from ..files import read_text, write_atomically

_FILE = "address.json"


class Address(BaseModel):
    """Where a studio was last reached: its port on this machine, and its token."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    springform_address: Literal[1] = 1
    port: int = Field(ge=0, le=65535)
    """0 if it was never reached."""
    token: str = Field(min_length=20, max_length=200)


def last_address(home: Path) -> Address:
    """Return the address that the studio with these documents had; a new one if it had none."""
    try:
        return Address.model_validate_json(read_text(home / _FILE))
    except (InputError, ValidationError):
        return Address(port=0, token=secrets.token_urlsafe(24))


def keep_address(home: Path, address: Address) -> None:
    """Keep an address for the next start, readable by its owner alone. Raises `WriteError`."""
    path = home / _FILE
    # An existing file keeps its permissions when it is written, so it is made narrow first.
    if not path.exists():
        os.close(os.open(path, os.O_CREAT | os.O_WRONLY, 0o600))
    path.chmod(0o600)
    write_atomically(path, json.dumps(address.model_dump(), indent=2).encode())
