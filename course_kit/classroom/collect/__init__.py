"""Hand-ins: folders and zips as learning systems export them, found and told apart by student."""
