"""The laboratory: what measures and judges the models.  It lies in the repository, not in the wheel; nothing else imports it."""
