# What the stub of the compiled part says of attributes that nanobind's generator does not know.
_core\..*\.__dataclass_fields__:
    \from dataclasses import Field
    \from typing import Any, ClassVar
    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]
