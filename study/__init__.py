"""Is PRRL-SMC faster? What equal tuning says: the study of docs/study, made anew by `make study`."""
