// SPDX-License-Identifier: BSD-3-Clause
#include "AvianLidarUndo.h"

#include "pqApplicationCore.h"
#include "pqRenderView.h"
#include "pqServerManagerModel.h"
#include "pqUndoStack.h"

#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMProxyManager.h"
#include "vtkSMRenderViewProxy.h"
#include "vtkSMSession.h"
#include "vtkSMUndoElement.h"
#include "vtkSMUndoStackBuilder.h"
#include "vtkWeakPointer.h"

#include <algorithm>
#include <vector>

namespace
{
constexpr const char* CameraProperties[] = { "CameraPosition", "CameraFocalPoint", "CameraViewUp",
  "CameraViewAngle", "CameraParallelScale" };
constexpr char Projection[] = "CameraParallelProjection";

/// Camera of a view.
struct Camera
{
  vtkWeakPointer<vtkSMRenderViewProxy> view;
  std::vector<std::vector<double>> values;
  int projection;

  explicit Camera(vtkSMRenderViewProxy* of)
    : view(of)
  {
    of->SynchronizeCameraProperties();
    for (const char* name : CameraProperties)
    {
      this->values.push_back(vtkSMPropertyHelper(of, name).GetDoubleArray());
    }
    this->projection = vtkSMPropertyHelper(of, Projection).GetAsInt();
  }

  void Set() const
  {
    for (std::size_t i = 0; this->view && i < this->values.size(); ++i)
    {
      vtkSMPropertyHelper(this->view, CameraProperties[i])
        .Set(this->values[i].data(), static_cast<unsigned int>(this->values[i].size()));
    }
    if (this->view)
    {
      vtkSMPropertyHelper(this->view, Projection).Set(this->projection);
      this->view->UpdateVTKObjects();
    }
  }
};

/// The cameras before and after a step.
class Cameras : public vtkSMUndoElement
{
public:
  static Cameras* New();
  vtkTypeMacro(Cameras, vtkSMUndoElement);

  static std::vector<Camera> Now()
  {
    std::vector<Camera> cameras;
    auto* model = pqApplicationCore::instance()->getServerManagerModel();
    for (pqRenderView* view : model->findItems<pqRenderView*>())
    {
      cameras.emplace_back(view->getRenderViewProxy());
    }
    return cameras;
  }

  /// Reads the cameras again. @return true if a camera of an earlier view has moved or is gone
  bool Moved()
  {
    this->After = Cameras::Now();
    const auto same = [this](const Camera& before)
    {
      return std::any_of(this->After.begin(), this->After.end(),
        [&before](const Camera& after)
        {
          return after.view == before.view && after.values == before.values &&
            after.projection == before.projection;
        });
    };
    return !std::all_of(this->Before.begin(), this->Before.end(), same);
  }

  int Undo() override { return Cameras::SetAll(this->Before); }
  int Redo() override { return Cameras::SetAll(this->After); }

  std::vector<Camera> Before = Cameras::Now();
  std::vector<Camera> After;

private:
  static int SetAll(const std::vector<Camera>& cameras)
  {
    for (const Camera& camera : cameras)
    {
      camera.Set();
    }
    return 1;
  }
};

vtkStandardNewMacro(Cameras);
}

//------------------------------------------------------------------------------
void AvianLidarDoToUndo(const QString& label, const std::function<void()>& work)
{
  pqUndoStack* stack = pqApplicationCore::instance()->getUndoStack();
  if (!stack)
  {
    work();
    return;
  }
  stack->beginUndoSet(label);
  vtkNew<Cameras> cameras;
  work();
  if (cameras->Moved())
  {
    cameras->SetSession(vtkSMProxyManager::GetProxyManager()->GetActiveSession());
    stack->GetUndoStackBuilder()->Add(cameras);
  }
  stack->endUndoSet();
}
