"""People: bodies made on this machine from MakeHuman's free data, with clothes and hair of ours."""
