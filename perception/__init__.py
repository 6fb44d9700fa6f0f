"""Images in, poses out: pure functions, no device, no clock."""
