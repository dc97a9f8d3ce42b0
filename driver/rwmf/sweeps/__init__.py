"""Many runs in chunks, on threads or any executor, into one labelled dataset."""
