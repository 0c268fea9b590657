"""Which node lives in which process, and what each uses of the machine."""
