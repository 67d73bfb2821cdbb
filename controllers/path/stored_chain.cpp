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

// The part that remains in memory.
Chain head_of(const Chain& chain) {
  Chain head;
  head.t = chain.t;
  head.duration = chain.duration;
  head.begin = chain.begin;
  head.end = chain.end;
  return head;
}

}  // namespace

template <class T>
StoredChain::Part StoredChain::write(const std::vector<T>& values) {
  return {file_->append(bytes_of(values)), values.size()};
}

template <class T>
void StoredChain::read(const Part& part, std::vector<T>& values) const {
  values.resize(part.count);
  file_->read(part.place, bytes_of(values));
}

StoredChain::StoredChain(std::shared_ptr<ScratchFile> file, const Chain& chain)
    : file_(std::move(file)),
      head_(head_of(chain)),
      pieces_(write(chain.plan->path.pieces)),
      vertices_(write(chain.plan->path.s)),
      phases_(write(chain.plan->law.phases)),
      spans_(write(chain.spans)),
      shares_(write(chain.shares)) {}

std::shared_ptr<const Chain> StoredChain::read() const {
  const std::scoped_lock lock(mutex_);
  if (auto chain = in_use_.lock()) return chain;
  const auto chain = std::make_shared<Chain>(head_);
  const auto plan = std::make_shared<Chain::Plan>();
  plan->law.duration = head_.duration;
  read(pieces_, plan->path.pieces);
  read(vertices_, plan->path.s);
  read(phases_, plan->law.phases);
  read(spans_, chain->spans);
  read(shares_, chain->shares);
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
  Chain head = head_of(chain);
  head.stored = std::make_shared<const StoredChain>(file_, chain);
  return head;
}

}  // namespace servomill::controllers
