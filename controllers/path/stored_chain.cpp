#include "controllers/path/stored_chain.h"

#include <utility>

namespace servomill::controllers {
namespace {

using Chain = Trajectory::Chain;

template <class T>
std::size_t size_of(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

std::size_t size_of(const Chain& chain) {
  return size_of(chain.plan->path.pieces) + size_of(chain.plan->path.s) +
         size_of(chain.plan->law.phases) + size_of(chain.spans) + size_of(chain.shares);
}

}  // namespace

StoredChain::StoredChain(std::shared_ptr<ScratchFile> file, const Chain& chain)
    : file_(std::move(file)),
      pieces_(chain.plan->path.pieces.size()),
      vertices_(chain.plan->path.s.size()),
      phases_(chain.plan->law.phases.size()),
      spans_(chain.spans.size()),
      shares_(chain.shares.size()) {
  head_.t = chain.t;
  head_.duration = chain.duration;
  head_.begin = chain.begin;
  head_.end = chain.end;
  place_ = file_->append(bytes_of(chain.plan->path.pieces));
  for (const auto& bytes : {bytes_of(chain.plan->path.s), bytes_of(chain.plan->law.phases),
                            bytes_of(chain.spans), bytes_of(chain.shares)}) {
    file_->append(bytes);
  }
}

std::shared_ptr<const Chain> StoredChain::read() const {
  const std::scoped_lock lock(mutex_);
  if (auto chain = in_use_.lock()) return chain;
  const auto chain = std::make_shared<Chain>(head_);
  const auto plan = std::make_shared<Chain::Plan>();
  plan->law.duration = head_.duration;
  std::uint64_t place = place_;
  const auto take = [&](auto& values, std::size_t count) {
    values.resize(count);
    const auto bytes = bytes_of(values);
    file_->read(place, bytes);
    place += bytes.size();
  };
  take(plan->path.pieces, pieces_);
  take(plan->path.s, vertices_);
  take(plan->law.phases, phases_);
  take(chain->spans, spans_);
  take(chain->shares, shares_);
  chain->plan = plan;
  in_use_ = chain;
  return chain;
}

// Plans that several chains share stay.
Chain ChainStore::keep(Chain chain) {
  if (chain.plan == nullptr || chain.plan.use_count() > 1) return chain;
  const std::size_t size = size_of(chain);
  if (size <= left_) {
    left_ -= size;
    return chain;
  }
  if (file_ == nullptr) file_ = std::make_shared<ScratchFile>("", "the planned motion");
  Chain head;
  head.t = chain.t;
  head.duration = chain.duration;
  head.begin = chain.begin;
  head.end = chain.end;
  head.stored = std::make_shared<const StoredChain>(file_, chain);
  return head;
}

}  // namespace servomill::controllers
