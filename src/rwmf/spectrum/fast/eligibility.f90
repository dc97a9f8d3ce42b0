!> Cases that method 'fast' covers; all others are left to the general lanes.
module rwmf_spectrum_fast_eligibility
   use rwmf_model_assembly, only: build_equation
   use rwmf_model_equation, only: equation_t
   use rwmf_motion_ground_motion, only: motion_t
   use rwmf_problem_case, only: case_t
   implicit none
   private

   public :: is_supported

contains

   !> Does the method cover a case? Its effects may add to inertia, moment, kinematics and damping
   !> what depends on the rotation alone; they may neither have a memory or states of their own nor
   !> follow a second record. It excludes a second run for `verify`, a
   !> requested accuracy or absolute tolerance, and factors of impacts that depend on the speed.
   logical function is_supported(case, motion)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion
      type(case_t) :: probe
      type(equation_t) :: equation

      is_supported = allocated(case%frame) .and. .not. (allocated(case%solver%accuracy) &
         .or. case%solver%verify .or. allocated(case%solver%atol) .or. allocated(case%storeys) &
         .or. allocated(case%vertical_record))
      if (is_supported .and. allocated(case%impact)) is_supported = case%impact%rule /= 'table'
      if (.not. is_supported) return
      probe%structure_t = case%structure_t
      probe%frame%T_s = 1
      if (allocated(case%wall)) probe%frame%gamma = 1
      call build_equation(probe, motion, equation)
      is_supported = equation%n == 2 .and. .not. (equation%has_bilinear_springs &
         .or. equation%has_loading_direction) .and. (equation%has_impacts .eqv. equation%has_wall)
      if (allocated(equation%effects) .or. allocated(case%initial)) is_supported = is_supported &
         .and. equation%has_wall
   end function is_supported

end module rwmf_spectrum_fast_eligibility
