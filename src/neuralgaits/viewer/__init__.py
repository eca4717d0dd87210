"""The live page: a robot walking in the browser, beside its phase portrait."""
