"""What every request is answered with."""
import dataclasses


@dataclasses.dataclass(frozen=True)
class Answer:
    """`success`, and one sentence: what happened, or why not."""

    success: bool
    message: str

    def as_dict(self):
        return dataclasses.asdict(self)


class Refused(Exception):
    """Bad input: `status` is the HTTP status, the sentence says what to mend."""

    def __init__(self, status, sentence):
        super().__init__(sentence)
        self.status = status
