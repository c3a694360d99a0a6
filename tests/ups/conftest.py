"""Archives that Uintah wrote, unpacked once; also makes ``small_decks`` importable from the folders below."""

import tarfile

import pytest


@pytest.fixture(scope="session")
def sus(shared, tmp_path_factory):
    """Return the path of an archive written by sus, by name."""
    folder = tmp_path_factory.mktemp("sus")

    def unpack(name):
        if not (folder / f"{name}.uda").exists():
            packed = shared / "archives" / f"{name}.uda.tar.gz"
            if not packed.exists():
                pytest.skip("the reference archives are not here")
            with tarfile.open(packed) as tar:
                tar.extractall(folder, filter="data")
        return folder / f"{name}.uda"

    return unpack
