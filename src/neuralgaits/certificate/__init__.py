"""Proofs that conditions hold for every state of their regions, and the check of such proofs.

`search/` finds proofs and does not judge them: its results go to a proof file that is read and
checked without it. So this room imports nothing by itself. The record of a certificate is
`records.certified.CertificateRecord`.
"""
