"""Why a check failed: exceptions, silence, logs that are missing, builds."""
