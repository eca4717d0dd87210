"""What a certificate says of a condition: never a bare boolean."""

from neuralgaits.records.certified import ConditionVerdict, Counterexample, Verdict

__all__ = ["ConditionVerdict", "Counterexample", "Verdict"]
