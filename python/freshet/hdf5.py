"""Search problems in the HDF5 layout of ann-benchmarks (train, test, neighbors, distances), for other programs."""
import h5py
import numpy

from . import SearchProblem

_DISTANCE = "manhattan"  # L1


def write_problem(problem, path):
    """Writes a SearchProblem: train (N, bins), test (Q, bins), uint8; neighbors (Q, k), int32; distances, float32."""
    with h5py.File(path, "w") as file:
        file.attrs["distance"] = _DISTANCE
        file.attrs["dimension"] = problem.patches.shape[1]
        file.attrs["point_type"] = "int"
        for name, array in (("train", problem.patches), ("test", problem.questions),
                            ("neighbors", problem.neighbours), ("distances", problem.distances)):
            file.create_dataset(name, data=array)


def read_problem(path):
    """SearchProblem of a file in that layout. ValueError where its distance is not L1 or its values are not 0 to 255."""
    with h5py.File(path, "r") as file:
        distance = file.attrs.get("distance")
        if distance != _DISTANCE:
            raise ValueError(f"{path}: its distance is {distance}, and {_DISTANCE} is expected")
        bytes_of = {}
        for name in ("train", "test"):
            values = file[name][:]
            bytes_of[name] = values.astype(numpy.uint8)
            if not numpy.array_equal(bytes_of[name], values):
                raise ValueError(f"{path}: {name} holds other values than whole numbers from 0 to 255")
        return SearchProblem(bytes_of["train"], bytes_of["test"], file["neighbors"][:].astype(numpy.int32),
                             file["distances"][:].astype(numpy.float32))
