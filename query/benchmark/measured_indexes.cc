#include "query/benchmark/measured_indexes.h"

namespace freshet::query {

// Each in a file of its own.
MeasuredIndex measured_flann_kdtree();
MeasuredIndex measured_flann_kmeans();
MeasuredIndex measured_flann_hierarchical();
MeasuredIndex measured_hnswlib();
MeasuredIndex measured_faiss_flat();
MeasuredIndex measured_faiss_hnsw();
MeasuredIndex measured_faiss_ivf();

std::vector<MeasuredIndex> measured_indexes() {
  return {
      measured_exact(),
      measured_scan(),
      measured_flann_kdtree(),
      measured_flann_kmeans(),
      measured_flann_hierarchical(),
      measured_hnswlib(),
      measured_faiss_flat(),
      measured_faiss_hnsw(),
      measured_faiss_ivf(),
  };
}

}  // namespace freshet::query
