"""Warnings of an export: what is not proved of its gait."""

from neuralgaits.certificate.run_certificate.verified_summary import CertificateReading


def unproved_of_export(certificate: CertificateReading) -> list[str]:
    """List what is not proved of this gait; agreement with Python says nothing about that."""
    if certificate.summary is None:
        why = certificate.reason or "it has no certificate"
        return [f"nothing is proved of this gait: {why}"]
    warnings = []
    for name, row in certificate.summary.conditions.items():
        if row.counterexample is not None:
            place = row.counterexample.place("{:.4g}".format)
            warnings.append(
                f"this gait is refuted: {name} is broken at {place}, as certify recorded"
            )
    if left := certificate.summary.named("undecided"):
        warnings.append(f"not proved of this gait: {', '.join(left)}")
    for level in certificate.summary.levels:
        if not level.proved:
            warnings.append(f"level {level.level} is not proved of this gait: {level.reason}")
    return warnings
